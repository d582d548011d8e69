"""The paper's claims, each judged by a small function of the states.

One module per group of claims: ``contraction`` (C1), ``stress`` (C2), ``pressure`` (C3 to C5),
``factors`` (C6 to C9) and here C10. ``judge`` asks one of them, ``scorecard`` asks them all of
several tables of states and adds how sure the answers are.
"""

from workflow.analyses.claims.claim import Claim, Claims, Data, Finding, Missing, Verdict
from workflow.analyses.claims.contraction import CLAIMS as CONTRACTION
from workflow.analyses.claims.factors import CLAIMS as FACTORS
from workflow.analyses.claims.pressure import CLAIMS as PRESSURE
from workflow.analyses.claims.stress import CLAIMS as STRESS

CLAIMS = Claims([*CONTRACTION, *STRESS, *PRESSURE, *FACTORS])


@CLAIMS.add("C10", "", "a case takes 27 minutes; silicone up to 1.5 hours", paper="27", unit="min")
def run_time(data: Data) -> Finding:
    """C10: a record is the same on every machine, so it holds no times."""
    raise Missing("times differ between machines and are no part of a record; see results/cost")


def judge(claim: Claim, data: Data) -> Finding:
    """What the data says of a claim; not testable where it says nothing."""
    try:
        return claim.judge(data)
    except Missing as missing:
        return Finding(float("nan"), Verdict.NOT_TESTABLE, str(missing))
