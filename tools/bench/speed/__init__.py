"""Speed beside peers: cases, peers, paired runs and their tables; the command is ../run.py."""
