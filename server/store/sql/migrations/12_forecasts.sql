-- What a frame was expected to take, told when a tenth of it was spent: it stands beside the outcome.
ALTER TABLE frames ADD COLUMN forecast_at REAL;
ALTER TABLE frames ADD COLUMN forecast_seconds REAL;
ALTER TABLE frames ADD COLUMN forecast_low REAL;
ALTER TABLE frames ADD COLUMN forecast_high REAL;
