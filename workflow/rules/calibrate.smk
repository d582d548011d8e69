# Measured forces -> stiffnesses of muscles: snakemake --cores 2 calibrate
#
#   in   the calibrations of the study file and their muscles; reference maps or a file of the user
#   out  results/tables/calibration.csv, calibration_values.csv
#        results/calibration/<name>.yaml    a muscle to paste into a study file
#        results/figures/calibration.png, .svg


rule calibrate:
    input:
        files=lambda _: measured_files(),
        sources=sources("workflow.programs.calibrate"),
    output:
        table="results/tables/calibration.csv",
        values="results/tables/calibration_values.csv",
        muscles=expand("results/calibration/{name}.yaml", name=PLAN.study.calibration),
        png="results/figures/calibration.png",
        svg="results/figures/calibration.svg",
    log:
        "results/logs/calibrate.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        asked=asked_calibrations(),
    message:
        "Fitting muscles to measured forces"
    shell:
        "python -m workflow calibrate --study {params.study:q} > {log:q} 2>&1"
