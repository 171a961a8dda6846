"""The rules, grouped by subject. The docstring of a rule is its page; see `rule.rule`."""
