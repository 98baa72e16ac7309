// Which surface a pixel sees. RASTER_SHAPES: boxes stand for surfaces that are not triangles, and a ray finds what is
// in them; the depth is then the shader's own, which costs every fragment.
layout(location = 0) flat in uint slot;
layout(location = 0) out uvec4 seen;

void main() {
    uint tag = LOAD(bvhTriangles, slot).w;
    Ray ray = rasterRay(uvec2(gl_FragCoord.xy) + drawnBlock().xy, pass.firstSample);
    seen = uvec4(slot, 0u, 0u, 0u);
#ifdef RASTER_SHAPES
    gl_FragDepth = gl_FragCoord.z;
    if ((tag & kBvhShape) != 0u) {
        Hit hit;
        if (!hitShapeAlone(slot, ray, hit)) discard;
        bool flat_ = has(FEATURE_ORTHOGRAPHIC) && parameters.cameraForward.w == CAMERA_ORTHOGRAPHIC;
        float ahead = hit.t * dot(ray.direction, cameraPose(frameKey(pass.firstSample)).forward);
        gl_FragDepth = flat_ ? 1.0 - ahead / parameters.integrator.w : parameters.integrator.z / ahead;
        return;
    }
#endif
    if (kBvhNonOpaque && (tag & kBvhAskAccept) != 0u &&
        !acceptHit(tag & ~kBvhAskAccept, barycentricsOf(makeShearRay(ray), slot), ray.key))
        discard;
}
