"""The pages of the report, and what each shows."""
