"""The rules, one module each.

The docstring of a module is the rule's page, and its name the rule's. It holds `CODE`, `SEVERITY`,
`NEEDS`, and a generator `check(case)` that yields what it finds.
"""
