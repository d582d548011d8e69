# What goes on around the jobs of a run: one run at a time, damaged results made again, FreeFEM looked
# at before anything is solved, and how far it is. No rules in this file.
#
#   out  results/logs/progress.log
from snakemake.dag import DAG
from snakemake.logging import logger
from snakemake.settings.enums import Quietness

from solver import freefem
from workflow.run import damage, lock
from workflow.run.progress import Progress, is_no_chatter

PROGRESS = []  # of the run that goes on


def solves(jobs):
    """Cases that jobs solve, by key."""
    return {
        job.wildcards.case: case_of(job.wildcards.case) for job in jobs if job.rule.name == "solve"
    }


def follow():
    """Show how the run goes instead of what Snakemake says of every job."""
    quiet = {Quietness.ALL, Quietness.PROGRESS}.intersection(workflow.output_settings.quiet or ())
    cases = {key: asked.case.model for key, asked in solves(workflow.dag.jobs).items()}
    progress = Progress(
        cases,
        solves(workflow.dag.needrun_jobs()),
        cores=workflow.cores or 1,
        log=Path("results/logs/progress.log"),
        terminal=None if quiet else sys.stderr,
    )
    logger.addHandler(progress)
    PROGRESS.append(progress)
    for handler in logger.handlers:
        if handler.name == "DefaultStreamHandler":
            handler.addFilter(is_no_chatter)


def check_freefem():
    """Stop before anything runs if a case needs FreeFEM and it does not work."""
    if any(asked.mesh for asked in solves(workflow.dag.needrun_jobs()).values()):
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
        await check_others(dag)

    DAG.check_incomplete = check
    return found


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
    workflow.scheduler.job_rate_limiter = None


DAMAGED = notice_damage()


onstart:
    lock.take(Path(".snakemake/run.lock"))
    clear_damage()
    lock.tidy(Path("results"))
    check_freefem()
    follow()
    look_once()


onsuccess:
    PROGRESS.pop().close()


onerror:
    PROGRESS.pop().close()
