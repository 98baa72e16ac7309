-- name: find
SELECT * FROM leases WHERE id = :id;

-- name: open
SELECT * FROM leases WHERE state = 'open' ORDER BY epoch;

-- name: lastEpoch
SELECT seq AS epoch FROM sqlite_sequence WHERE name = 'leases';

-- name: insert
INSERT INTO leases (epoch, id, worker, job, frame, state, granted, passes, session, machine, loss)
VALUES (:epoch, :id, :worker, :job, :frame, :state, :granted, :passes, :session, :machine, :loss);

-- name: close
UPDATE leases SET state = :state WHERE epoch = :epoch;

-- name: forgetClosedBefore
DELETE FROM leases WHERE epoch IN (
    SELECT epoch FROM leases INDEXED BY leases_closed
     WHERE state <> 'open' AND granted < :granted ORDER BY granted LIMIT :limit);

-- name: lost
SELECT * FROM leases INDEXED BY leases_lost WHERE loss <> 'none' ORDER BY epoch;

-- name: setLoss
UPDATE leases SET loss = :loss WHERE epoch = :epoch;

-- name: addDeaths
INSERT INTO deaths (job, frame, first_sample, tile, deaths)
VALUES (:job, :frame, :first_sample, :tile, max(0, :count))
ON CONFLICT DO UPDATE SET deaths = max(0, deaths + :count);

-- name: deadly
SELECT * FROM deaths WHERE job = :job AND deaths >= :least ORDER BY frame, first_sample, tile LIMIT 1;

-- name: forgetDeaths
DELETE FROM deaths WHERE job = :job;

-- name: addFailure
INSERT INTO failures (job, frame, tile, first_sample, worker, message, reports)
VALUES (:job, :frame, :tile, :first_sample, :worker, :message, :reports)
ON CONFLICT DO UPDATE SET message = excluded.message, reports = reports + excluded.reports;

-- name: failures
SELECT * FROM failures WHERE job = :job AND frame = :frame AND tile = :tile AND first_sample = :first_sample;

-- name: jobsOnlyThisWorkerFailed
SELECT count(DISTINCT f.job) AS jobs FROM failures AS f
 WHERE f.worker = :worker AND EXISTS (
    SELECT 1 FROM contributions AS c WHERE c.job = f.job AND c.worker <> :worker AND c.passes > 0);
