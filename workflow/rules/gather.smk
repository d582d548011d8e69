# Records -> dataset, and tables of what failed and of how far it is from what was measured.
#
#   in   all records of the study; the reference maps
#   out  results/dataset.nc             layout: workflow/data/dataset.py
#        results/states.parquet         the same states, one row each: workflow/data/tidy.py
#        results/tables/failures.csv    what did not work out; often a header only
#        results/tables/deviation.csv   from the maps, of the muscles that these are of
#        results/complete.txt           if no case failed; else the run ends with an error here


rule gather:
    input:
        records=[record_of(case) for case in PLAN.cases],
        sources=sources("workflow.programs.gather"),
    output:
        dataset="results/dataset.nc",
        states="results/states.parquet",
        failures="results/tables/failures.csv",
        deviation=deviations(),
    log:
        "results/logs/gather.log",
    priority: 1
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        plan=PLAN.digest(),
        deviation=["--deviation", *deviations()] if deviations() else [],
    message:
        "Gathering the records of all cases"
    shell:
        "python -m workflow gather --study {params.study:q}"
        " --dataset {output.dataset:q} --states {output.states:q} --failures {output.failures:q}"
        " {params.deviation:q} 2> {log:q}"


# What has been solved so far, of an unfinished study: snakemake --cores 1 partial
rule partial:
    log:
        "results/logs/partial.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
    message:
        "Gathering and drawing what is solved, into results/partial"
    shell:
        "python -m workflow partial --study {params.study:q} 2>&1 | tee {log:q} >&2"


rule complete:
    input:
        figures=figures(),
        dataset="results/dataset.nc",
        failures="results/tables/failures.csv",
        sources=sources("workflow.programs.failures"),
    output:
        touch("results/complete.txt"),
    log:
        "results/logs/complete.log",
    message:
        "Checking that no case failed"
    shell:
        "python -m workflow failures --table {input.failures:q} 2> {log:q}"
