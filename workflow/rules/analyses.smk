# Analyses of the models, each a target of its name: snakemake --cores 2 robustness
#
#   in   the records of its cases; files of the user (by content); workflow/analyses/<name>/
#   out  results/tables/<name>.csv            and others beside it
#        results/tables/<name>_failures.csv   cases that did not work out
#        results/figures/<...>.png, .svg
#        results/<name>/<...>                 other files, of some
#        a group of results/dataset.nc, of some; rows of results/tables/failures.csv
#
# What each of these is for one analysis stands in its folder (workflow/analyses/analysis.py).

for each in ANALYSES.values():

    rule:
        name:
            each.target or each.name
        input:
            solved=lambda wildcards, name=each.name: solved(f"analysis-{name}"),
            # Added to, not read. Not ancient(): with that Snakemake (9.27) leaves the analysis out of
            # a run in which the dataset is gathered again, even where its outputs are missing.
            dataset=f"{RESULTS}/dataset.nc" if each.in_dataset else [],
        output:
            tables=expand("{folder}/tables/{table}.csv", folder=RESULTS, table=each.tables),
            failures=[f"{RESULTS}/tables/{each.failures}"] if each.solves_cases else [],
            files=[f"{RESULTS}/{each.name}/{file}" for file in each.files(PLAN.study)],
            figures=expand(
                "{folder}/figures/{figure}.{kind}",
                folder=RESULTS,
                figure=each.figures,
                kind=["png", "svg"],
            ),
        log:
            f"{RESULTS}/logs/analyses/{each.name}.log",
        params:
            study=lambda _: STUDY,  # as it is, braces and all
            name=each.name,
            files=lambda wildcards, files=each.inputs(PLAN.study): {
                file: seal_of(Path(file)) for file in files
            },
            asked=lambda wildcards, name=each.name: ANALYSES[name].digest(PLAN.study),
            code=lambda wildcards, modules=each.modules: code(
                "workflow.programs.analysis", *modules
            ),
        message:
            f"Evaluating the analysis {each.name}"
        shell:
            "python -m workflow analysis --study {params.study:q} --name {params.name:q}"
            " > {log:q} 2>&1"
