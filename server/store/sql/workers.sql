-- name: list
SELECT * FROM workers ORDER BY worker;

-- name: put
INSERT OR REPLACE INTO workers (
    worker, host, device, driver, version, state, reason, first_seen, last_seen)
VALUES (:worker, :host, :device, :driver, :version, :state, :reason, :first_seen, :last_seen);

-- name: forgetSeenBefore
DELETE FROM workers WHERE last_seen < :last_seen;

-- name: contributions
SELECT * FROM contributions WHERE job = :job ORDER BY worker;

-- name: addContribution
INSERT INTO contributions (job, worker, device_seconds, passes, samples)
VALUES (:job, :worker, :device_seconds, :passes, :samples)
ON CONFLICT DO UPDATE SET
    device_seconds = device_seconds + excluded.device_seconds,
    passes = passes + excluded.passes, samples = samples + excluded.samples;

-- name: reports
SELECT * FROM reports WHERE job = :job ORDER BY worker;

-- name: putReport
INSERT OR REPLACE INTO reports (job, worker, json) VALUES (:job, :worker, :json);
