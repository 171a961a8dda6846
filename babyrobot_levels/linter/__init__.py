"""The linter: rules of play and of style for levels that load but are not what was intended.

Rules of play are proved from the compiled tables. `rules/` contains the rules, `errors/` the pages
of the error codes.
"""
