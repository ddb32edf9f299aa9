"""Files of a run: frames for ParaView, tables, checkpoints and the summary; all from snapshots."""
