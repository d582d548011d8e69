"""The explorer: one page beside the dataset, in which all of its curves can be looked at.

It needs no server and no network. ``content.py`` says what it shows, ``page.py`` puts that into the
template beside it; charts are drawn by uPlot (``vendor/``).
"""
