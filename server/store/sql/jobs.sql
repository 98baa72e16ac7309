-- name: findById
SELECT * FROM jobs WHERE id = :id;

-- name: findByKey
SELECT * FROM jobs WHERE key = :key;

-- name: findByIdempotencyKey
SELECT * FROM jobs WHERE idempotency_key = :idempotency_key;

-- name: list
SELECT * FROM jobs WHERE key < :before ORDER BY key DESC LIMIT :limit;

-- name: listInState
SELECT * FROM jobs WHERE state = :state AND key < :before ORDER BY key DESC LIMIT :limit;

-- name: leasable
SELECT key FROM jobs INDEXED BY jobs_leasable
 WHERE state IN ('queued','running') AND passes > passes_merged + passes_leased
 ORDER BY priority DESC, key LIMIT :limit OFFSET :offset;

-- name: totals
SELECT * FROM job_totals;

-- name: oldestQueued
SELECT created FROM jobs WHERE state = 'queued' ORDER BY key LIMIT 1;

-- name: spec
SELECT json FROM specs WHERE job = :job;

-- name: insertSpec
INSERT INTO specs (job, json) VALUES (:job, :json);

-- name: insert
INSERT INTO jobs (
    id, state, priority, outline, idempotency_key, body_digest, created, started, finished,
    passes, passes_merged, pixel_samples, pixel_samples_merged,
    frames, frames_started, frames_done, samples_merged, relative_error, device_seconds,
    dropped_samples, faults, rejected_paths, truncated_paths, fault_samples,
    truncated_throughput, clamped_samples, clamped_luminance, kept_luminance,
    suspect_frame, died_on, set_aside, lights_behind_glass)
VALUES (
    :id, :state, :priority, :outline, :idempotency_key, :body_digest, :created, :started, :finished,
    :passes, :passes_merged, :pixel_samples, :pixel_samples_merged,
    :frames, :frames_started, :frames_done, :samples_merged, :relative_error, :device_seconds,
    :dropped_samples, :faults, :rejected_paths, :truncated_paths, :fault_samples,
    :truncated_throughput, :clamped_samples, :clamped_luminance, :kept_luminance,
    :suspect_frame, :died_on, :set_aside, :lights_behind_glass);

-- name: update
UPDATE jobs SET
    state = :state, priority = :priority, started = :started, finished = :finished,
    passes = :passes, passes_merged = :passes_merged,
    pixel_samples = :pixel_samples, pixel_samples_merged = :pixel_samples_merged,
    frames_started = :frames_started, frames_done = :frames_done, samples_merged = :samples_merged,
    relative_error = :relative_error, device_seconds = :device_seconds,
    dropped_samples = :dropped_samples, faults = :faults, rejected_paths = :rejected_paths,
    truncated_paths = :truncated_paths, fault_samples = :fault_samples,
    truncated_throughput = :truncated_throughput, clamped_samples = :clamped_samples,
    clamped_luminance = :clamped_luminance, kept_luminance = :kept_luminance,
    suspect_frame = :suspect_frame, died_on = :died_on, set_aside = :set_aside,
    lights_behind_glass = :lights_behind_glass
 WHERE key = :key;
