-- name: find
SELECT * FROM passes WHERE job = :job AND frame = :frame AND first_sample = :first_sample AND tile = :tile;

-- name: lowestQueued
SELECT first_sample FROM passes INDEXED BY passes_queued
 WHERE job = :job AND frame = :frame AND first_sample >= :from AND state = 'queued'
 ORDER BY first_sample, tile LIMIT 1;

-- name: counts
SELECT coalesce(sum(state = 'queued'), 0) AS queued, coalesce(sum(state = 'leased'), 0) AS leased,
       coalesce(sum(state = 'merged'), 0) AS merged, coalesce(sum(state = 'failed'), 0) AS failed
  FROM passes WHERE job = :job AND frame = :frame;

-- name: leasedWithoutLease
SELECT * FROM passes INDEXED BY passes_leased
 WHERE state = 'leased' AND NOT EXISTS (
    SELECT 1 FROM leases WHERE leases.epoch = passes.epoch AND leases.state = 'open')
 LIMIT :limit;

-- name: held
SELECT * FROM passes INDEXED BY passes_held WHERE held_file IS NOT NULL;

-- name: heldOf
SELECT * FROM passes INDEXED BY passes_held_of_tile
 WHERE job = :job AND frame = :frame AND tile = :tile AND held_file IS NOT NULL ORDER BY first_sample;

-- name: isHeld
SELECT 1 FROM passes INDEXED BY passes_held WHERE held_file = :held_file LIMIT 1;

-- name: oldestQueued
SELECT queued_at AS oldest FROM passes INDEXED BY passes_oldest WHERE state = 'queued' ORDER BY queued_at LIMIT 1;

-- name: insertLevel
WITH RECURSIVE t(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM t WHERE i + 1 < :tiles)
INSERT INTO passes (job, frame, first_sample, tile, samples, state, epoch, held_file, held_offset, queued_at)
SELECT :job, :frame, :first_sample, i, :samples, 'queued', 0, NULL, NULL, :now FROM t;

-- name: insert
INSERT INTO passes (job, frame, first_sample, tile, samples, state, epoch, held_file, held_offset, queued_at)
VALUES (:job, :frame, :first_sample, :tile, :samples, 'queued', 0, NULL, NULL, :now);

-- name: claim
UPDATE passes SET state = 'leased', epoch = :epoch
 WHERE job = :job AND frame = :frame AND first_sample = :first_sample AND tile IN (
    SELECT p.tile FROM passes AS p INDEXED BY passes_queued
     WHERE p.job = :job AND p.frame = :frame AND p.first_sample = :first_sample AND p.state = 'queued'
       AND (NOT EXISTS (SELECT 1 FROM failures AS f WHERE f.job = :job AND f.frame = :frame
                           AND f.tile = p.tile AND f.first_sample = :first_sample AND f.worker = :worker)
            OR (SELECT count(*) FROM failures AS f WHERE f.job = :job AND f.frame = :frame
                   AND f.tile = p.tile AND f.first_sample = :first_sample) >= :online_workers)
     ORDER BY p.tile LIMIT :limit)
RETURNING tile, first_sample, samples;

-- name: update
UPDATE passes SET
    state = :state, epoch = :epoch, held_file = :held_file, held_offset = :held_offset, queued_at = :queued_at
 WHERE job = :job AND frame = :frame AND first_sample = :first_sample AND tile = :tile;

-- name: release
UPDATE passes SET state = 'queued', queued_at = :now WHERE epoch = :epoch AND state = 'leased';

-- name: drop
DELETE FROM passes WHERE job = :job AND frame = :frame AND first_sample < :below;
