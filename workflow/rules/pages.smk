# Which pages the report has, in which chapters. No rules in this file.
PAPER, VERDICT, ACCURACY = "1 The paper's figures", "2 The verdict", "3 Accuracy"
EFFECTS, HARD = "4 Effects", "5 Hard cases"
CHAPTERS = {  # of what is no figure of the paper; a study that is not named is an effect
    "claims": VERDICT,
    "deviation": VERDICT,
    "calibration": VERDICT,
    "accuracy": ACCURACY,
    "robustness": HARD,
    "failures": HARD,
}
# A report is of the pages, so they are the target then.
REPORTING = any(argument.partition("=")[0] == "--report" for argument in sys.argv)


def page_sources():
    """Chapter, title, pictures and tables of every page there may be, by name."""
    pages = {}
    for scene in filter(drawn, PLAN.study.scenes):
        judged = ["results/tables/claims.csv"] if has_claims() else []
        title = re.sub("^fig0?", "Figure ", scene)
        pages[scene] = PAPER, title, [f"results/figures/{scene}.png"], judged
    if has_claims():
        pages["claims"] = VERDICT, "The paper's claims", [], ["results/tables/claims.csv"]
    for table in map(Path, [*deviations(), "results/tables/failures.csv"]):
        pages[table.stem] = CHAPTERS[table.stem], table.stem.capitalize(), [], [str(table)]
    if PLAN.study.calibration:
        fitted = ["results/tables/calibration_values.csv", "results/tables/calibration.csv"]
        pictures = ["results/figures/calibration.png"]
        pages["calibration"] = VERDICT, "Calibration", pictures, fitted
    for study, pictures in analysis.FIGURES.items():
        if pictures and has_claims():
            drawn_by = expand("results/figures/{picture}.png", picture=pictures)
            notes = [f"results/tables/{study}_notes.csv"] if study in analysis.NOTED else []
            pages[study] = CHAPTERS.get(study, EFFECTS), study.capitalize(), drawn_by, notes
    return pages


def has_claims():
    """Whether the study is that of the paper, which claims and studies are about."""
    muscles = PLAN.study.muscles
    papers = "dmsp20" in muscles and paper.is_normal(muscles["dmsp20"])
    return papers and "dmsp20_silicone" in muscles


def caption_of(page):
    """What a page shows; a new figure may have none yet."""
    own = Path(of_checkout(f"workflow/report/{page}.rst"))
    return own if own.exists() else own.with_name("unnamed.rst")


PAGES = page_sources()


def pages():
    """All pages; of a report those that are there."""
    files = [f"results/report/{page}.html" for page in PAGES]
    if not REPORTING:
        return files
    found = [file for file in files if Path(file).exists()]
    if not found:
        sys.exit("There is no page to report yet: run snakemake --cores 2 everything first")
    return found
