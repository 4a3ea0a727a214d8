#!/usr/bin/env bash
#SBATCH --job-name=bounce
#SBATCH --array=0-99
#SBATCH --cpus-per-task=1
#SBATCH --time=00:10:00
# One hundredth of a study: sbatch slurm.sh values.txt
# values.txt has one value a line. Submitted again, it goes on where it was interrupted.
set -euo pipefail
: "${REBOND:=rebond}" "${SLURM_ARRAY_TASK_ID:=0}" "${SLURM_ARRAY_TASK_COUNT:=1}"
mkdir -p recordings
awk -v task="$SLURM_ARRAY_TASK_ID" -v tasks="$SLURM_ARRAY_TASK_COUNT" 'NR % tasks == task' "$1" |
    while read -r name value; do
        "$REBOND" record bounce.toml -o "recordings/$name.mcap" --set restitution.default="$value" --skip-existing --quiet
    done
