// Camera rays. Pixel (0, 0) is the top left; what lies around it, pixel_filter.glsl says.
#ifndef CAMERA_GLSL
#define CAMERA_GLSL

// The camera at one moment.
struct CameraPose {
    vec3 origin;
    vec3 forward;  // unit
    vec3 right;    // half width of the image plane at distance 1 (perspective) or in metres (orthographic)
    vec3 up;       // half height, likewise
};

// Quaternions as (x, y, z, w), of unit length.
vec3 rotated(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

// The way from a to b at an even rate. Keys are stored so that dot(a, b) >= 0.
vec4 slerp(vec4 a, vec4 b, float t) {
    float angle = 2.0 * atan(length(a - b), length(a + b));  // exact for small angles too, unlike acos
    float sine = sin(angle);
    // The weights' limit for small angles, where both are sines over each other; relative error below 1e-6 there.
    vec2 weights = angle < 1e-3 ? vec2(1.0 - t, t) : vec2(sin((1.0 - t) * angle), sin(t * angle)) / sine;
    return normalize(weights.x * a + weights.y * b);
}

// Between two keys: rotation | pivot, half height | offset from the pivot in the camera's axes, aspect. The rotation is
// slerped and the rest linear, so a camera that circles its pivot stays on the circle.
CameraPose poseAt(float time) {
    uint last = parameters.cameraKeyCount - 1u;
    float at = time * float(last);
    uint from = min(uint(at), last - 1u);
    float t = at - float(from);
    uint k = from * CAMERA_KEY_VECTORS;
    vec4 q = slerp(parameters.cameraKeys[k], parameters.cameraKeys[k + 3u], t);
    vec4 pivot = mix(parameters.cameraKeys[k + 1u], parameters.cameraKeys[k + 4u], t);
    vec4 offset = mix(parameters.cameraKeys[k + 2u], parameters.cameraKeys[k + 5u], t);
    CameraPose pose;
    pose.origin = pivot.xyz + rotated(q, offset.xyz);
    pose.forward = rotated(q, vec3(0, 0, -1));
    pose.right = rotated(q, vec3(pivot.w * offset.w, 0, 0));
    pose.up = rotated(q, vec3(0, pivot.w, 0));
    return pose;
}

CameraPose cameraPose(SampleKey key) {
    if (has(FEATURE_CAMERA_MOTION) && parameters.cameraKeyCount > 1u) {
        float u = unitFloat(randomBits(key, DIMENSION_TIME).x);
        return poseAt(parameters.shutterBegin + parameters.shutterLength * u);
    }
    return CameraPose(parameters.cameraOrigin, parameters.cameraForward, parameters.cameraRight,
                      parameters.cameraUp);
}

// Uniform on the unit disk, or on the regular polygon inscribed in it.
vec2 apertureSample(vec2 u) {
    float blades = parameters.lensBlades;
    if (blades < 3.0) {
        float r = sqrt(u.x), phi = TWO_PI * u.y;
        return vec2(r * cos(phi), r * sin(phi));
    }
    float side = min(floor(u.x * blades), blades - 1.0);
    vec2 b = uniformTriangle(vec2(u.x * blades - side, u.y));
    vec2 angles = parameters.lensRotation + TWO_PI / blades * vec2(side, side + 1.0);
    return b.x * vec2(cos(angles.x), sin(angles.x)) + b.y * vec2(cos(angles.y), sin(angles.y));
}

// Where on the lens a ray starts, from its middle.
vec3 lensShift(SampleKey key, CameraPose pose) {
    vec2 onLens = parameters.lensRadius * apertureSample(unitFloat(randomBits(key, DIMENSION_LENS).xy));
    return onLens.x * normalize(pose.right) + onLens.y * normalize(pose.up);
}

// Every direction around the camera, equirectangular: the picture's middle is forward, its top up.
vec3 panoramaDirection(CameraPose pose, vec2 ndc) {
    float longitude = PI * ndc.x, latitude = 0.5 * PI * ndc.y;
    return cos(latitude) * (cos(longitude) * pose.forward + sin(longitude) * normalize(pose.right)) +
           sin(latitude) * normalize(pose.up);
}

// Of a pose, whatever rounded it, the ray is the same bits in every kernel.
void rayFrom(CameraPose pose, SampleKey key, vec2 ndc, out vec3 origin, out vec3 direction) {
    precise vec3 offset = ndc.x * pose.right + ndc.y * pose.up;
    origin = pose.origin;
    if (has(FEATURE_ORTHOGRAPHIC) && parameters.cameraKind == CAMERA_ORTHOGRAPHIC) {
        origin = pose.origin + offset;
        direction = pose.forward;
    } else if (has(FEATURE_PANORAMA) && parameters.cameraKind == CAMERA_PANORAMA) {
        direction = normalize(panoramaDirection(pose, ndc));
    } else {
        precise vec3 through = pose.forward + offset;
        vec3 towards = through;
        if (has(FEATURE_THIN_LENS) && parameters.lensRadius > 0.0) {
            vec3 shift = lensShift(key, pose);
            origin = pose.origin + shift;
            towards = through - shift * parameters.lensInverseFocus;  // all through one point of the plane in focus
        }
        direction = normalize(towards);
    }
}

void cameraRay(SampleKey key, vec2 raster, out vec3 origin, out vec3 direction) {
    vec2 ndc = vec2(2.0, -2.0) * raster / vec2(parameters.imageSize) + vec2(-1.0, 1.0);
    rayFrom(cameraPose(key), key, ndc, origin, direction);
}

// Whether rays other than the camera's pass back faces.
bool cullsAll() { return has(FEATURE_CULLING) && parameters.cullingKind == CULLING_ALL; }

// The camera's ray as far as its clipping planes let it see; it passes the backs that are culled. `cutout` is its key.
Ray viewRay(SampleKey key, vec3 origin, vec3 direction, uint cutout) {
    Ray ray = freeRay(origin, direction, INFINITY, cutout);
    if (!has(FEATURE_CULLING)) return ray;
    ray.culls = parameters.cullingKind != CULLING_NONE;
    if (parameters.cameraClips == 0u) return ray;
    vec2 reach = parameters.clipping / dot(direction, cameraPose(key).forward);
    ray.tMin = reach.x;
    ray.tMax = reach.y;
    return ray;
}

#endif
