# Records -> fields for ParaView, of the states at which a scene asks for stress or the deformed shape.
#
#   in   a record
#   out  results/fields/<muscle>_<model>_<variant>_<path>_<held>_<stop>.vtu


rule fields:
    input:
        record=lambda wildcards: record_of(FIELD_FILES[wildcards.file][0]),
        sources=lambda _: sources("workflow.programs.fields"),
    output:
        "results/fields/{file}",
    log:
        "results/logs/fields/{file}.log",
    params:
        state=lambda wildcards: FIELD_FILES[wildcards.file][1],
    message:
        "Writing the fields {wildcards.file}"
    shell:
        "python -m workflow fields --record {input.record:q} --state {params.state:q}"
        " --output {output:q} > {log:q} 2>&1"
