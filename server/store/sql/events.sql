-- name: list
SELECT * FROM events WHERE id > :after ORDER BY id LIMIT :limit;

-- name: listOfJob
SELECT * FROM events WHERE job = :job AND id > :after ORDER BY id LIMIT :limit;

-- name: lastId
SELECT coalesce(max(seq), 0) AS id FROM sqlite_sequence WHERE name = 'events';

-- name: add
INSERT INTO events (job, job_id, at, type, json) VALUES (:job, :job_id, :at, :type, :json);

-- name: forgetBelow
DELETE FROM events WHERE id IN (SELECT id FROM events WHERE id < :id ORDER BY id LIMIT :limit);
