# Figures, tables and the scorecard -> pages -> one report for the browser:
#
#   snakemake --cores 2 everything
#   snakemake --report results/report.html
#
#   in   results/figures, results/tables; workflow/report/<page>.rst or
#        workflow/analyses/<page>/caption.rst, what each page shows
#   out  results/report/<page>.html    caption, figure, the claims that are of it, tables
#
# The report holds the pages that are there; it is made of files, and nothing runs for it.
report: "../report/workflow.rst"


for page_name, parts in PAGES.items():
    page_chapter, page_title, page_caption, page_pictures, page_tables = parts

    rule:
        name:
            f"page_{re.sub('[^A-Za-z0-9]', '_', page_name)}"
        input:
            # those of scenes are not Snakemake's own (figures.smk)
            pictures=rules.figures.output if page_name in DRAWN else page_pictures,
            tables=page_tables,
            additions=added_to(page_name),
        output:
            report(
                f"{RESULTS}/report/{page_name}.html",
                caption=os.path.relpath(page_caption, Path(CHECKOUT, "workflow/rules")),
                category=page_chapter,
                labels={"page": page_title},
            ),
        log:
            f"{RESULTS}/logs/report/{page_name}.log",
        params:
            title=page_title,
            caption=os.path.relpath(page_caption),
            pictures=page_pictures,
            text=page_caption.read_text(),
            code=lambda _: code("workflow.programs.page"),
        message:
            f"Writing the page {page_name}"
        shell:
            "python -m workflow page --title {params.title:q} --caption {params.caption:q}"
            " --pictures {params.pictures:q} --tables {input.tables:q} --output {output:q}"
            " > {log:q} 2>&1"
