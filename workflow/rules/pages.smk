# Which pages the report has, in which chapters (workflow/report/pages.py). No rules in this file.
from workflow.report.pages import of_study

PAGES = {
    page.name: page
    for page in of_study(
        PLAN, Path(RESULTS), DRAWN, [*deviations(), f"{RESULTS}/tables/failures.csv"]
    )
}
# Of analyses that take hours those that are asked for by name are in a report.
USUAL = [page for page in PAGES if page not in ANALYSES or not ANALYSES[page].takes_hours]
# A report is of the pages that can be made of what there is, and no job runs for it.
REPORTING = any(argument.partition("=")[0] == "--report" for argument in sys.argv)
