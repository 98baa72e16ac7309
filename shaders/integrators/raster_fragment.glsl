// Which surface a pixel sees. RASTER_SHAPES: boxes stand for surfaces that are not triangles, and a ray finds what is
// in them; the depth is then the shader's own, which costs every fragment.
layout(location = 0) flat in uint slot;
layout(location = 0) out uvec4 seen;

// Metres from the camera's plane to what is drawn.
float aheadOfFragment() {
    bool flat_ = has(FEATURE_ORTHOGRAPHIC) && parameters.cameraKind == CAMERA_ORTHOGRAPHIC;
    return flat_ ? (1.0 - gl_FragCoord.z) * parameters.farPlane : 1.0 / gl_FragCoord.w;
}

bool isClipped() {
    if (!has(FEATURE_CULLING) || parameters.cameraClips == 0u) return false;
    float ahead = aheadOfFragment();
    return ahead < parameters.clipping.x || ahead > parameters.clipping.y;
}

bool isBackOf(uint triangle, vec3 direction) {
    vec3 corner[3];
    loadCorners(Hit(0.0, 0u, vec2(0), triangle), corner);
    return dot(cross(corner[1] - corner[0], corner[2] - corner[0]), direction) > 0.0;
}

void main() {
    uint tag = LOAD(bvhTriangles, slot).w;
    Ray ray = rasterRay(uvec2(gl_FragCoord.xy) + drawnBlock().xy, pass.firstSample);
    seen = uvec4(slot, 0u, 0u, 0u);
#ifdef RASTER_SHAPES
    gl_FragDepth = gl_FragCoord.z;
    if ((tag & kBvhShape) != 0u) {
        Hit hit;
        if (!hitShapeAlone(slot, ray, hit)) discard;
        bool flat_ = has(FEATURE_ORTHOGRAPHIC) && parameters.cameraKind == CAMERA_ORTHOGRAPHIC;
        float ahead = hit.t * dot(ray.direction, cameraPose(frameKey(pass.firstSample)).forward);
        gl_FragDepth = flat_ ? 1.0 - ahead / parameters.farPlane : parameters.nearPlane / ahead;
        return;
    }
#endif
    if (isClipped() || (mayCull(ray, tag) && isBackOf(slot, ray.direction))) discard;
    if (kBvhNonOpaque && (tag & kBvhAskAccept) != 0u &&
        !acceptHit(tag & kBvhPrimitive, barycentricsOf(makeShearRay(ray), slot), ray.key))
        discard;
}
