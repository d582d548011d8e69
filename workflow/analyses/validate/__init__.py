"""What measured muscles say of the model, before and after a fit of one number."""
