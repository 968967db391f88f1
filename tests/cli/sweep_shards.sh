#!/usr/bin/env bash
# A sweep by four shards and their merge holds what one process finds: sweep_shards.sh PROGRAM.
# The shards are examples/sweep/shards.slurm as an array of a Slurm that is started for it on this
# machine; where Slurm is not installed, one after the other.  The units of systemd are looked
# through where it is.
set -euo pipefail
export GEAR3K
GEAR3K=$(realpath "$1")
examples=$(realpath "$(dirname "$0")/../../examples/sweep")
folder=$(mktemp -d)
started=()
end() {
  local program k number
  [ ${#started[@]} -lt 3 ] || scancel --quiet --user="$(id -un)" 2>/dev/null || true
  for program in "${started[@]}"; do
    number=$(cat "$folder/$program.pid" 2>/dev/null) || continue
    kill "$number" 2>/dev/null || true
    for ((k = 0; k < 50; k++)); do
      kill -0 "$number" 2>/dev/null || break
      sleep 0.1
    done
  done
  rm -rf "$folder"
}
trap end EXIT
cd "$folder"
script=$examples/shards.slurm

if command -v systemd-analyze >/dev/null 2>&1; then
  mkdir units
  sed "s|/usr/bin/gear3k|$GEAR3K|" "$examples/gear3k-sweep.service" >units/gear3k-sweep.service
  cp "$examples/gear3k-sweep.timer" units
  systemd-analyze verify units/gear3k-sweep.* >units/said 2>&1 || { cat units/said; exit 1; }
  # What it does not know it says, and counts as no error.
  if grep gear3k-sweep units/said; then exit 1; fi
fi

cat >small.toml <<'TOML'
name = "eight small tasks"
[task]
preset = "machined"
[task.ratio]
tolerance = 0.01
[task.teeth]
S = [12, 15]
P1 = [30, 40]
R1_max = 110
P2 = [24, 34]
R2_max = 110
[task.module]
stage1_mm = { min = 0.4, max = 1.0 }
stage2_mm = { min = 0.4, max = 1.0 }
[task.size]
max_ring_root_diameter_mm = 76.0
[vary]
ratio.target = [60, 90, 200, 1000]
backlash.max_output_arcmin = [6.0, 12.0]
TOML
"$GEAR3K" sweep small.toml --out single.db --quiet >/dev/null

# A Slurm of this user alone: all of its files are in the folder.
start_slurm() {
  local node user port=$((20000 + $$ % 20000))
  node=$(hostname -s) user=$(id -un)
  mkdir state spool
  (umask 077 && head -c 1024 /dev/urandom >key)
  munged --force --key-file="$folder/key" --socket="$folder/socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munged.log" --seed-file="$folder/seed" >/dev/null 2>&1 || return 1
  started=(munged)
  cat >slurm.conf <<CONF
ClusterName=shards
SlurmctldHost=$node(127.0.0.1)
AuthInfo=socket=$folder/socket
SlurmUser=$user
SlurmdUser=$user
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc)
PartitionName=all Nodes=$node Default=YES
CONF
  export SLURM_CONF=$folder/slurm.conf
  slurmctld -i >/dev/null 2>&1 || return 1
  started=(slurmctld munged)
  slurmd >/dev/null 2>&1 || return 1
  started=(slurmd slurmctld munged)
  local k
  for ((k = 0; k < 100; k++)); do
    [ "$(sinfo --noheader --format=%t 2>/dev/null)" != idle ] || return 0
    sleep 0.1
  done
  return 1
}

# Waits without asking Slurm more than three times a second.
run_on_slurm() {
  local job k
  job=$(sbatch --parsable --array=1-4 --output=shard-%a.log "$script" small.toml shards 4)
  for ((k = 0; k < 300; k++)); do
    [ -n "$(squeue --noheader --jobs="$job" 2>/dev/null)" ] || return 0
    sleep 0.3
  done
  squeue
  return 1
}

if command -v slurmctld slurmd munged sbatch >/dev/null 2>&1 && start_slurm; then
  run_on_slurm
  echo "four shards under $(sbatch --version)"
else
  # As GoogleTest has it: ./check shows these lines.
  echo "[  SKIPPED ] sweep_shards: no Slurm could be started, one shard after the other (0 ms)"
  for shard in 1 2 3 4; do
    SLURM_ARRAY_TASK_ID=$shard bash "$script" small.toml shards 4 >"shard-$shard.log" 2>&1 ||
      { cat "shard-$shard.log"; exit 1; }
  done
fi
[ -f shards/shard-4.db ] || { cat ./*.log; exit 1; }
"$GEAR3K" sweep merge shards/shard-*.db --out merged.db --quiet >/dev/null

# All that a database says of tasks and designs, by what the tasks are and not by their numbers.
content() {
  local columns sql
  columns=$("$GEAR3K" sweep query "$1" "SELECT group_concat('d.\"' || name || '\"', ', ')
    FROM pragma_table_info('design') WHERE name <> 'task'")
  for sql in "SELECT key, spec_key, revision, spec, status, reason, sets, merit, bound, best
      FROM task t ORDER BY key" \
    "SELECT t.key, $columns FROM design d JOIN task t ON t.id = d.task ORDER BY t.key, rank" \
    "SELECT t.key, path, value FROM task_key v JOIN task t ON t.id = v.task
      JOIN key k ON k.id = v.key ORDER BY t.key, path" \
    "SELECT t.key, r.status, r.reason, r.sets FROM refusal r JOIN task t ON t.id = r.task
      ORDER BY t.key, r.status, r.reason"; do
    "$GEAR3K" sweep query "$1" "$sql" --format csv
  done
}
content single.db >single.txt
content merged.db >merged.txt
[ "$(grep -c . single.txt)" -gt 30 ]
cmp single.txt merged.txt
