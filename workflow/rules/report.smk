# Figures, tables and the scorecard -> pages -> one report for the browser:
#
#   snakemake --cores 2 everything
#   snakemake --report results/report.html
#
#   in   results/figures, results/tables; workflow/report/<page>.rst or
#        workflow/analyses/<page>/caption.rst, what each page shows
#   out  results/report/<page>.html    caption, figure, the claims that are of it, tables
#
# The report opens with the verdict (workflow/report/opening.py). It is made of what is there, also
# after a usual run, which makes no pages: no job runs for a report, so it writes those that can be.
if REPORTING:
    from workflow.report import opening

    READY = [page for page in PAGES.values() if page.is_ready]
    REPORTED = [reported(page) for page in READY] + explored()
    if not REPORTED:
        sys.exit("There is nothing to report yet: run snakemake --cores 2 first")
    OPENING = opening.prepare(PLAN, Path(RESULTS), READY)

    report: str(OPENING.resolve())

else:

    for page in PAGES.values():

        rule:
            name:
                f"page_{re.sub('[^A-Za-z0-9]', '_', page.name)}"
            input:
                # those of scenes are not Snakemake's own (figures.smk)
                pictures=(
                    rules.figures.output if page.name in DRAWN else list(map(str, page.pictures))
                ),
                tables=list(map(str, (*page.tables, *page.judged))),
                additions=added_to(page.name),
            output:
                f"{RESULTS}/report/{page.name}.html",
            log:
                f"{RESULTS}/logs/report/{page.name}.log",
            params:
                title=page.title,
                caption=os.path.relpath(page.caption),
                pictures=list(map(str, page.pictures)),
                text=page.caption.read_text(),
                code=lambda _: code("workflow.programs.page"),
            message:
                f"Writing the page {page.name}"
            shell:
                "python -m workflow page --title {params.title:q} --caption {params.caption:q}"
                " --pictures {params.pictures:q} --tables {input.tables:q} --output {output:q}"
                " > {log:q} 2>&1"
