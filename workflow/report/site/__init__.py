"""The site: pages of docs/ by Sphinx, with what is made of the code."""
