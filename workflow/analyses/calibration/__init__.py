"""Stiffnesses of a muscle from measured forces: ``snakemake --cores 2 calibrate``."""
