# Records -> dataset, and tables of what failed and of how far it is from what was measured.
#
#   in   all records of the study; the reference maps
#   out  results/dataset.nc             layout: workflow/data/dataset.py
#        results/states.parquet         the same states, one row each: workflow/data/tidy.py
#        results/tables/failures.csv    what did not work out; often a header only
#        results/tables/deviation.csv   from the maps, of the muscles that these are of
#        results/explorer.html          a page in which all curves can be looked at
#        results/complete.txt           if no case failed; else the run ends with an error here


rule gather:
    input:
        solved("study"),
    output:
        dataset=f"{RESULTS}/dataset.nc",
        states=f"{RESULTS}/states.parquet",
        failures=f"{RESULTS}/tables/failures.csv",
        deviation=deviations(),
        explorer=f"{RESULTS}/explorer.html",
    log:
        f"{RESULTS}/logs/gather.log",
    priority: 1
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        plan=PLAN.digest(),
        code=lambda _: code("workflow.programs.gather"),
        deviation=["--deviation"] if deviations() else [],
    message:
        "Gathering the records of all cases"
    shell:
        "python -m workflow gather --study {params.study:q} {params.deviation:q} 2> {log:q}"


# What has been solved so far, of an unfinished study: snakemake --cores 1 partial
rule partial:
    log:
        f"{RESULTS}/logs/partial.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
    message:
        f"Gathering and drawing what is solved, into {RESULTS}/partial"
    shell:
        "python -m workflow partial --study {params.study:q} 2>&1 | tee {log:q} >&2"


rule complete:
    input:
        figures=rules.figures.output,
        dataset=f"{RESULTS}/dataset.nc",
        failures=f"{RESULTS}/tables/failures.csv",
    output:
        touch(f"{RESULTS}/complete.txt"),
    log:
        f"{RESULTS}/logs/complete.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        code=lambda _: code("workflow.programs.failures"),
    message:
        "Checking that no case failed"
    shell:
        "python -m workflow failures --study {params.study:q} 2> {log:q}"
