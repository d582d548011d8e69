"""The muscle that meets requirements: ``snakemake --cores 2 design``."""
