"""The parts of the audit of a submission; :mod:`irsim.api.audit_submission` puts them together."""
