"""The shaking table with frames and contacts on it: runs by exudyn, and what a run leaves."""
