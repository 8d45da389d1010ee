"""A Slurm cluster of three nodes on this machine, apart from any cluster that already runs here."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "sinfo", "squeue")
# Debian has daemons in folders that are not in every PATH.
PATH = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
NODES = ("node1", "node2", "node3")
POLL_S = 0.02
POLLS_MOST = 4000  # 80 s, and more on a slow machine

CONFIGURATION = """\
ClusterName=sonject
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
MailProg=/bin/true
SelectType=select/linear
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,batch_sched_delay=0,bf_interval=1,sched_min_interval=0
SlurmdParameters=config_overrides
ReturnToService=0
KillWait=20
RequeueExit=85,137
NodeName=node1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1
NodeName=node2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1
NodeName=node3 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[3]} CPUs=1
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def why_not():
    """Returns the reason why no cluster can start here, or None."""
    absent = [name for name in PROGRAMS if not shutil.which(name, path=PATH)]
    if absent:
        return "not installed: " + ", ".join(absent)
    return None if os.geteuid() == 0 else "Slurm's daemons are started as root only"


def wait_for(what, found, polls_at_once=1):
    """Polls until found() gives something true and returns that. polls_at_once raises the polling rate."""
    for _ in range(POLLS_MOST * polls_at_once):
        answer = found()
        if answer:
            return answer
        time.sleep(POLL_S / polls_at_once)
    raise AssertionError(f"in vain waited for {what}")


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def processes_with(*variables):
    """Returns the numbers of all processes whose environment holds each "NAME=value"."""
    wanted = {variable.encode() for variable in variables}
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*/environ"):
        try:
            held = path.read_bytes().split(b"\0")
        except OSError:  # the process has ended
            continue
        if wanted.issubset(held):
            found.append(int(path.parent.name))
    return found


def send(process, number):
    """Sends a signal and returns whether the process still exists."""
    try:
        os.kill(process, number)
    except ProcessLookupError:
        return False
    return True


def kill(processes):
    for process in processes:
        send(process, signal.SIGKILL)


class Cluster:
    """The daemons of a cluster. They write to their own folder, whose name is short since it holds
    sockets. Daemons are found by the environment's PATH, and jobs get the same environment."""

    def __init__(self, folder, environment):
        self.folder = pathlib.Path(folder)
        self.daemons = {}
        self.mark = f"SLURM_CONF={self.folder}/slurm.conf"
        kept = {name: value for name, value in environment.items()
                if not name.startswith(("SLURM", "SBATCH", "MUNGE"))}
        self.environment = {**kept, "SLURM_CONF": f"{self.folder}/slurm.conf"}

    def start(self):
        self.folder.chmod(0o755)  # munged demands these permissions
        (self.folder / "state").mkdir()
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            folder=self.folder, host=socket.gethostname().split(".")[0], ports=free_ports(4)))
        self.start_munge()
        self.start_daemon("slurmctld", "slurmctld", "-D", "-c")
        for node in NODES:
            self.start_node(node)
        self.wait_for("three idle nodes", lambda: self.nodes("idle") == set(NODES))

    def wait_for(self, what, found):
        """Waits for found(), and fails as soon as a daemon has ended."""
        wait_for(what, lambda: self.none_ended() and found())

    def none_ended(self):
        for name, daemon in self.daemons.items():
            assert daemon.poll() is None, (name, (self.folder / f"{name}.log").read_text())
        return True

    def start_munge(self):
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        names = [f"--{name}-file={self.folder}/munge.{name}" for name in ("pid", "seed")]
        self.start_daemon("munged", "munged", "--foreground", f"--key-file={key}", *names,
                          f"--socket={self.folder}/munge.socket")
        self.wait_for("munge's socket", (self.folder / "munge.socket").exists)

    def start_node(self, node):
        self.start_daemon(node, "slurmd", "-D", "-c", "-N", node)

    def start_daemon(self, name, *command):
        """Starts a daemon at a low priority. Jobs inherit the priority, so tests observe them in time."""
        with open(self.folder / f"{name}.log", "wb") as log:
            self.daemons[name] = subprocess.Popen(
                ["nice", "-n", "5", *command], env=self.environment, cwd=self.folder,
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True)

    def stop(self):
        """Ends all daemons and jobs."""
        for daemon in self.daemons.values():
            daemon.kill()
            daemon.wait()
        wait_for("the end of all jobs", lambda: not self.kill_rest())

    def kill_rest(self):
        rest = processes_with(self.mark)
        kill(rest)
        return rest

    def try_call(self, *command, **options):
        return subprocess.run([str(word) for word in command], env=self.environment, text=True,
                              capture_output=True, timeout=120, check=False, **options)

    def call(self, *command, **options):
        """Runs one of Slurm's commands and returns its output."""
        answer = self.try_call(*command, **options)
        assert answer.returncode == 0, (command, answer.stderr)
        return answer.stdout

    def nodes(self, states):
        return set(self.try_call("sinfo", "-h", "-N", "-t", states, "-o", "%N").stdout.split())

    def job(self, name):
        """Returns Slurm's values for a job or for one task of an array."""
        told = self.call("scontrol", "--oneliner", "show", "job", name)
        return dict(word.split("=", 1) for word in told.split() if "=" in word)

    def queue(self, job):
        """Returns squeue's lines for the rest of a job."""
        return self.try_call("squeue", "--noheader", f"--jobs={job}").stdout

    def start_again(self, name):
        """Waits for a requeued task and lets it start 2 s later on any node. A node takes a task for
        killed if the task starts in the same second in which it ended there before."""
        wait_for("a requeued task", lambda: self.job(name)["Reason"] == "BeginTime")
        self.call("scontrol", "update", f"jobid={name}", "StartTime=now+2")
