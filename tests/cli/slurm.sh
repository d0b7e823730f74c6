#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A study as a job array on a Slurm of one node on loopback, which this script starts and ends; a task is requeued while it runs.
#   slurm.sh ADIT STUDY.sbatch STUDY.toml OUT WORK     as root; WORK an empty folder, by its absolute path
set -euo pipefail
adit=$1 batch=$2 study=$3 out=$4 S=$5
mkdir -p "$S/state" "$S/spool" "$S/log"
dd if=/dev/urandom bs=1 count=1024 of="$S/munge.key" status=none
chmod 600 "$S/munge.key"
chmod go-w "$S" "$S/log"
cat >"$S/slurm.conf" <<CONF
ClusterName=adit
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$S/munge.sock
CredType=cred/munge
SlurmctldPort=16817
SlurmdPort=16818
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation=$S/state
SlurmdSpoolDir=$S/spool
SlurmctldPidFile=$S/slurmctld.pid
SlurmdPidFile=$S/slurmd.pid
SlurmctldLogFile=$S/log/slurmctld.log
SlurmdLogFile=$S/log/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
ReturnToService=2
KillWait=2
NodeName=$(hostname) NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
SchedulerParameters=sched_min_interval=0,batch_sched_delay=0,sched_interval=1,bf_interval=1
CONF
ended() {
  for daemon in slurmd slurmctld munged; do
    if [ -s "$S/$daemon.pid" ]; then kill "$(cat "$S/$daemon.pid")" 2>/dev/null || true; fi
  done
}
trap ended EXIT
munged --key-file="$S/munge.key" --socket="$S/munge.sock" --pid-file="$S/munged.pid" --log-file="$S/log/munged.log" \
  --seed-file="$S/munged.seed" --force
slurmctld -f "$S/slurm.conf"
slurmd -f "$S/slurm.conf"
export SLURM_CONF=$S/slurm.conf ADIT=$adit
for _ in $(seq 60); do sinfo -h -o %t 2>/dev/null | grep -q idle && break; sleep 0.5; done
job=$(sbatch --parsable --array=1-2 --cpus-per-task=1 --mem-per-cpu=0 --output="$S/log/task-%a.txt" "$batch" "$study" "$out")
for _ in $(seq 240); do  # requeued after its first cell, before its last
  ls "$out/cells" 2>/dev/null | grep -q . && break
  sleep 0.1
done
scontrol requeue "${job}_1" && echo "requeued"
for _ in $(seq 1200); do  # Slurm lets a requeued task wait two minutes
  left=$(squeue -h -j "$job" 2>/dev/null) && [ -z "$left" ] && break
  sleep 0.5
done
cat "$S"/log/task-*.txt
"$adit" study merge "$out" --quiet
