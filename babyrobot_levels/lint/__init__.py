"""Faults of play and of style: levels that load, and are not what their authors meant.

Rules are proved from the compiled tables where they speak of play. Each has a file of its own in
`rules/`, whose docstring is the rule's page.
"""
