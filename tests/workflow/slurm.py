"""A Slurm of two nodes on this machine, by Debian's packages, all of it in one folder."""

import os
import re
import shutil
import socket
import subprocess
import time
from pathlib import Path

CONFIGURATION = Path("/etc/slurm/slurm.conf")  # where jobs look for it
PACKAGES = ("slurm-wlm", "slurmctld", "slurmd", "slurm-client", "munge")
SETTINGS = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
ReturnToService=2
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmdSpoolDir={folder}/slurmd.%n
StateSaveLocation={folder}/state
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
SlurmdParameters=config_overrides
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=sched_min_interval=0,batch_sched_delay=0,bf_interval=1
MinJobAge=300
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
InactiveLimit=0
KillWait=2
PartitionName=all Nodes={names} Default=YES MaxTime=INFINITE State=UP
"""
NODE = (
    "NodeName={name} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=4 RealMemory=20000\n"
)
NODES = ("one", "two")  # a job of profiles/slurm fills one


def install() -> None:
    """Debian's packages, if they are not there."""
    if shutil.which("slurmctld") and shutil.which("slurmd") and shutil.which("munged"):
        return
    apt = ["apt-get", "-qq", "-o", "DPkg::Lock::Timeout=120"]
    settings = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    options = {"env": settings, "check": True, "capture_output": True, "timeout": 300}
    subprocess.run([*apt, "update"], **options)
    subprocess.run([*apt, "install", "-y", "--no-install-recommends", *PACKAGES], **options)


class Cluster:
    """Begins with ``with`` and ends behind it; this machine may have no other one."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._processes: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> "Cluster":
        self.folder.chmod(0o755)
        host = socket.gethostname().partition(".")[0]
        names = ",".join(NODES)
        text = SETTINGS.format(host=host, folder=self.folder, names=names, controller=_free_port())
        nodes = [NODE.format(name=name, host=host, port=_free_port()) for name in NODES]
        (self.folder / "slurm.conf").write_text("".join(nodes) + text)
        assert CONFIGURATION.is_symlink() or not CONFIGURATION.exists(), "a Slurm of its own"
        CONFIGURATION.unlink(missing_ok=True)
        CONFIGURATION.symlink_to(self.folder / "slurm.conf")
        for name in ("state", *(f"slurmd.{node}" for node in NODES)):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        files = {"socket": "socket", "key-file": "key", "pid-file": "pid", "log-file": "log"}
        options = [f"--{name}={self.folder}/munge.{ending}" for name, ending in files.items()]
        self._begin("munged", "--foreground", "--force", *options, f"--seed-file={key}.seed")
        self._wait(lambda: (self.folder / "munge.socket").exists(), "munged")
        self._begin("slurmctld", "-D")
        for node in NODES:
            self._begin("slurmd", "-D", "-N", node)
        self._wait(lambda: self._idle() == len(NODES), "slurmctld, slurmd")
        return self

    def __exit__(self, *_: object) -> None:
        self.run("scancel", "--me")
        for process in reversed(self._processes):
            process.terminate()
        for process in self._processes:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
        CONFIGURATION.unlink(missing_ok=True)

    def run(self, *command: str) -> str:
        """What a program of Slurm prints."""
        return subprocess.run(command, capture_output=True, text=True, timeout=30).stdout

    def jobs(self, state: str) -> list[str]:
        """Numbers of the jobs in a state."""
        return self.run("squeue", "-h", "-o", "%i", "-t", state).split()

    def job_of_batch(self, number: int) -> str:
        """The number of the job that runs for a batch of the study."""
        running = self.run("squeue", "-h", "-o", "%i %k", "-t", "RUNNING").splitlines()
        job_of = dict(reversed(line.split()) for line in running)
        return job_of[f"rule_solve_wildcards_study_{number}"]

    def nodes_of_jobs(self) -> set[str]:
        """Nodes on which jobs of the last minutes have run."""
        return set(re.findall(r"\bNodeList=(\w+)", self.run("scontrol", "show", "jobs")))

    def _idle(self) -> int:
        return self.run("sinfo", "-N", "-h", "-o", "%t").split().count("idle")

    def wait_for_job(self, seconds: float = 90) -> str:
        """The number of a job, as soon as one runs."""
        self._wait(lambda: self.jobs("RUNNING"), "a job", seconds)
        return self.jobs("RUNNING")[0]

    def _begin(self, name: str, *arguments: str) -> None:
        program = shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin:/sbin")
        assert program is not None
        number = len(self._processes)
        with (self.folder / f"{name}.{number}.out").open("wb") as out:
            self._processes.append(subprocess.Popen([program, *arguments], stdout=out, stderr=out))

    def _wait(self, ready, what: str, seconds: float = 30) -> None:
        end = time.monotonic() + seconds
        while not ready():
            logs = "".join(path.read_text()[-600:] for path in self.folder.glob("*.out"))
            assert time.monotonic() < end, f"{what}: not there after {seconds:g} s\n{logs}"
            time.sleep(0.1)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
