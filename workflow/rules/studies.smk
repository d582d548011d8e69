# Studies of the models themselves, each a target of its name: snakemake --cores 2 robustness
#
#   in   the records of the study's cases; workflow/analyses/<name>/
#   out  results/tables/<name>.csv    all that its figures draw
#        results/tables/<name>_notes.csv, for some: what a reader must know of it
#        results/figures/<...>.png, .svg
#        a group of results/dataset.nc, for some (workflow/analyses/dataset_groups.py)

for study_name, study_figures in analysis.FIGURES.items():

    rule:
        name:
            study_name
        input:
            records=lambda wildcards, name=study_name: map(record_of, cases_of_study(name)),
            sources=sources("workflow.programs.analysis", f"workflow.analyses.{study_name}.cases"),
            # Added to, not read. Not ancient(): with that Snakemake (9.27) leaves the study out of
            # a run in which the dataset is gathered again, even where its outputs are missing.
            dataset="results/dataset.nc" if study_name in analysis.IN_DATASET else [],
        output:
            table=f"results/tables/{study_name}.csv",
            notes=[f"results/tables/{study_name}_notes.csv"] if study_name in analysis.NOTED else [],
            figures=expand(
                "results/figures/{figure}.{kind}", figure=study_figures, kind=["png", "svg"]
            ),
        log:
            f"results/logs/studies/{study_name}.log",
        params:
            study=lambda _: STUDY,  # as it is, braces and all
            name=study_name,
        message:
            f"Evaluating the study {study_name}"
        shell:
            "python -m workflow analysis --study {params.study:q} --name {params.name:q}"
            " --table {output.table:q} > {log:q} 2>&1"
