"""From the study file to cases, and from records to dataset, figures and verdicts."""
