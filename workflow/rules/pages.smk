# Which pages the report has, in which chapters. No rules in this file.
PAPER, VERDICT, HARD = "1 The paper's figures", "2 The verdict", "5 Hard cases"
CHAPTERS = {"deviation": VERDICT, "failures": HARD}  # of tables of the scenes; analyses have theirs
# A report is of the pages, so they are the target then.
REPORTING = any(argument.partition("=")[0] == "--report" for argument in sys.argv)


def page_sources():
    """Chapter, title, caption, pictures and tables of every page there may be, by name."""
    pages = {}
    fitting = [each for each in ANALYSES.values() if each.fits(PLAN.study)]
    judged = [f"{RESULTS}/tables/{each.name}.csv" for each in fitting if each.on_figures]
    for scene in DRAWN:
        title = re.sub("^fig0?", "Figure ", scene)
        pages[scene] = PAPER, title, caption_of(scene), [f"{RESULTS}/figures/{scene}.png"], judged
    for table in map(Path, [*deviations(), f"{RESULTS}/tables/failures.csv"]):
        name = table.stem
        pages[name] = CHAPTERS[name], name.capitalize(), caption_of(name), [], [str(table)]
    for each in fitting:
        pictures = [f"{RESULTS}/figures/{picture}.png" for picture in each.figures]
        tables = [f"{RESULTS}/tables/{table}.csv" for table in each.page]
        pages[each.name] = each.chapter, each.title, each.caption, pictures, tables
    return pages


def added_to(page):
    """What is added to the table of a page when analyses end, so that the page comes after that."""
    if page != "failures":
        return []
    fitting = [each for each in ANALYSES.values() if each.fits(PLAN.study) and each.solves_cases]
    return [f"{RESULTS}/tables/{each.failures}" for each in fitting]


def caption_of(page):
    """What a figure or table of the scenes shows; a new figure may have no words yet."""
    own = Path(CHECKOUT, "workflow/report", f"{page}.rst")
    return own if own.exists() else own.with_name("unnamed.rst")


PAGES = page_sources()


def pages():
    """All pages; of a report those that are there."""
    files = [f"{RESULTS}/report/{page}.html" for page in PAGES]
    if not REPORTING:
        return files
    found = [file for file in files if Path(file).exists()]
    if not found:
        sys.exit("There is no page to report yet: run snakemake --cores 2 everything first")
    return found
