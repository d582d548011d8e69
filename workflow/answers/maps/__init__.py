"""Tables of a muscle for controllers and simulators: ``snakemake --cores 2 maps``."""
