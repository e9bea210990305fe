#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs a command with a Slurm of its own, of this machine alone; for trying things.
#   one_node_slurm.sh FOLDER COMMAND [ARGUMENT]...
# FOLDER must not be there yet. It holds all that this Slurm has (configuration, key, state, logs) and is
# removed at the end; only if Slurm did not start, it stays, with the logs. Nothing outside of it is touched,
# nothing that runs is disturbed: ports are free ones, and daemons run as whoever calls this. Exit code: the
# command's; 4 if Slurm did not start. KELP_SLURM_CPUS: how many CPUs this Slurm says it has (default: those
# of the machine). Needs munge and slurm-wlm: tools/setup.sh farm.
set -euo pipefail

case "${1:-}" in
  -h|--help) sed -n '3,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
[ $# -ge 2 ] || { echo "one_node_slurm.sh: give a folder and a command; see --help" >&2; exit 1; }
PATH=$PATH:/usr/sbin:/sbin  # where Debian has the daemons
for program in munged slurmctld slurmd sbatch; do
  command -v "$program" >/dev/null ||
    { echo "one_node_slurm.sh: $program is not here; install it: tools/setup.sh farm" >&2; exit 1; }
done
[ ! -e "$1" ] || { echo "one_node_slurm.sh: $1: is there already; name a folder that is not" >&2; exit 1; }
mkdir -p "$1" && chmod 755 "$1"
folder=$(cd "$1" && pwd)
shift

pids=() started=0
finish() {
  local code=$?
  trap - EXIT INT TERM
  if [ "$started" -eq 1 ]; then
    scancel --user="$(id -un)" 2>/dev/null || true
    for _ in $(seq 50); do  # until the jobs' processes are gone
      [ -n "$(squeue --noheader 2>/dev/null)" ] || break
      sleep 0.2
    done
  fi
  # The last one that was started ends first.
  for ((i = ${#pids[@]} - 1; i >= 0; --i)); do
    kill "${pids[i]}" 2>/dev/null || true
    wait "${pids[i]}" 2>/dev/null || true
  done
  if [ "$started" -eq 1 ]; then rm -rf "$folder"; fi
  exit "$code"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

read -r controller_port node_port < <(python3 - <<'PY'
import socket
sockets = [socket.socket() for _ in range(2)]
for s in sockets:
    s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))
PY
)
host=$(hostname -s)
mkdir "$folder/state" "$folder/spool"
memory=$(awk '/^MemTotal/ {print int($2 / 1024)}' /proc/meminfo)
cat >"$folder/slurm.conf" <<CONF
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller_port
SlurmdPort=$node_port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=${KELP_SLURM_CPUS:-$(nproc)} RealMemory=$memory
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE
CONF
export SLURM_CONF=$folder/slurm.conf USER=${USER:-$(id -un)}  # Snakemake asks for USER

(umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key")
munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
  --pid-file="$folder/munge.pid" --seed-file="$folder/munge.seed" \
  --log-file="$folder/munge.log" >"$folder/munged.out" 2>&1 &
pids+=($!)
for _ in $(seq 50); do [ ! -S "$folder/munge.socket" ] || break; sleep 0.1; done
slurmctld -D >"$folder/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D -N "$host" >"$folder/slurmd.out" 2>&1 &
pids+=($!)
for _ in $(seq 150); do
  if sinfo --noheader --format=%T 2>/dev/null | grep -qx idle; then started=1; break; fi
  sleep 0.2
done
[ "$started" -eq 1 ] ||
  { echo "one_node_slurm.sh: Slurm did not start; its logs are in $folder" >&2; exit 4; }

"$@"
