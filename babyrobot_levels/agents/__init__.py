"""What plays levels: agents as tables of policies, files of played episodes, many levels."""
