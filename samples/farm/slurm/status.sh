#!/bin/sh
# SPDX-License-Identifier: MIT
# What has become of a job, in Snakemake's words: running, success or failed. Usage: status.sh JOB
state=$(scontrol --oneliner show job "$1" 2>/dev/null | sed -n 's/.* JobState=\([A-Z_]*\).*/\1/p' | head -n 1)
# Slurm forgets a job minutes after its end; its accounting, where there is one, does not.
[ -n "$state" ] || state=$(
  sacct --allocations --noheader --parsable2 --format=State --jobs="$1" 2>/dev/null | head -n 1)
# No answer is no end: the controller may be busy, or starting again.
[ -n "$state" ] || scontrol ping 2>/dev/null | grep -q UP || state=UNKNOWN
case "$state" in
  COMPLETED) echo success ;;
  UNKNOWN|PENDING|CONFIGURING|RUNNING|SUSPENDED|STOPPED|COMPLETING|RESIZING|SIGNALING|\
  STAGE_OUT|REQUEUED|REQUEUE_FED|REQUEUE_HOLD|SPECIAL_EXIT|RESV_DEL_HOLD)
    echo running ;;
  *) echo failed ;;
esac
