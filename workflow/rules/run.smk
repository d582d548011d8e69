# What goes on around the jobs of a run: one run at a time, damaged results made again, FreeFEM looked
# at before anything is solved, and how far it is. No rules in this file.
#
#   out  results/logs/progress.log
import signal

from snakemake.dag import DAG
from snakemake.logging import logger
from snakemake.persistence import PersistenceBase
from snakemake.settings.enums import Quietness

from solver import freefem
from workflow.run import damage, lock
from workflow.run.progress import Progress, is_no_chatter

LOCK = Path(".snakemake/run.lock")
PROGRESS = []  # of the run that goes on


def solves(jobs):
    """Cases of the batches among some jobs, by key."""
    found = {}
    for job in jobs:
        if job.rule.name == "solve":
            found.update(cases_of_batch(job.wildcards))
    return found


def follow():
    """Show how the run goes instead of what Snakemake says of every job."""
    quiet = {Quietness.ALL, Quietness.PROGRESS}.intersection(workflow.output_settings.quiet or ())
    progress = Progress(
        {key: asked.case.model for key, asked in solves(workflow.dag.jobs).items()},
        batches.to_solve(solves(workflow.dag.needrun_jobs())),
        cores=workflow.cores or 1,
        log=RESULTS / "logs/progress.log",
        terminal=None if quiet else sys.stderr,
    )
    logger.addHandler(progress)
    PROGRESS.append(progress)
    for handler in logger.handlers:
        if handler.name == "DefaultStreamHandler":
            handler.addFilter(is_no_chatter)


def check_freefem():
    """Stop before anything runs if a case needs FreeFEM and it does not work."""
    cases = solves(workflow.dag.needrun_jobs())
    if any(cases[key].mesh for key in batches.to_solve(cases)):
        try:
            freefem.check()
        except freefem.FreeFemError as error:
            sys.exit(str(error))


def notice_damage():
    """Make results again that are missing or of another size, with all that is made of them.

    Snakemake compares times, and looks for those files only that somebody asks for or reads.
    """
    found = damage.noticed()
    check_others = DAG.check_incomplete  # of files that a killed run has left

    async def check(dag):
        dag.forcefiles.update(found)
        for job in dag.jobs:
            lost = any(str(path) in found or not path.is_file() for path in made_beside(job))
            if lost or job.rule.name == "figure" and will_be_drawn(job.wildcards.figure):
                dag.forcefiles.update(job.output)
        await check_others(dag)

    DAG.check_incomplete = check
    return found


def made_beside(job):
    """Files that a job makes beside those that Snakemake knows."""
    if job.rule.name == "figures":
        return update.files(PLAN, RESULTS)
    cases = solves([job])
    return [path for key, asked in cases.items() for path in batches.files_of(key, asked)]


def clear_damage():
    """Make room where something else than a file stands in the place of a result."""
    for path in DAMAGED:
        if not Path(path).is_file():
            damage.remove(Path(path))


def look_once():
    """Look for ready jobs when one has ended, and not also every second, once more per job that has.

    So does Snakemake (9.27) to start at most 100 jobs a second, which no run here does: of a run of
    67 jobs it takes a fifth of the processor time.
    """
    if workflow.local_exec:  # a cluster's limit is the user's
        workflow.scheduler.job_rate_limiter = None


def spare_pandas():
    """Compare parameters as they are: for those that are data frames, which no rule here has,
    Snakemake (9.27) imports pandas in every run, a fifth of one with nothing to do.
    """
    PersistenceBase._serialize_param = property(lambda self: self._serialize_param_builtin)


def where_results_are():
    page = RESULTS / "explorer.html"
    return f"Results are in {RESULTS}" + (f"; open {page} in a browser" if page.exists() else "")


def interrupted(*_):
    """Ctrl-C: end with one sentence; Snakemake tidies up and is not heard."""
    if not PROGRESS:
        print(STOPPED, file=sys.stderr)
        os._exit(1)  # nothing has begun
    for handler in logger.handlers:
        if handler.name == "DefaultStreamHandler":
            handler.addFilter(lambda _: False)
    PROGRESS[0].stop(STOPPED)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it is known
    raise KeyboardInterrupt


damage.end_future(RESULTS)
spare_pandas()
STOPPED = "Stopped. What is solved and drawn stays; the next run goes on from there."
DAMAGED = notice_damage()
signal.signal(signal.SIGINT, interrupted)


onstart:
    lock.take(LOCK, cluster=not workflow.local_exec)
    folders.take(STUDY)
    clear_damage()
    lock.tidy(Path("results"))
    sources.remember()
    check_freefem()
    follow()
    look_once()


onsuccess:
    lock.ended(LOCK)
    PROGRESS.pop().close(where_results_are())


onerror:
    lock.ended(LOCK)
    PROGRESS.pop().close()
