// Camera rays. Pixel (0, 0) is the top left; the pixel filter is a box.
#ifndef CAMERA_GLSL
#define CAMERA_GLSL

void cameraRay(vec2 raster, out vec3 origin, out vec3 direction) {
    vec2 ndc = vec2(2.0, -2.0) * raster / vec2(parameters.image.xy) + vec2(-1.0, 1.0);
    precise vec3 offset = ndc.x * parameters.cameraRight.xyz + ndc.y * parameters.cameraUp.xyz;
    if (has(FEATURE_ORTHOGRAPHIC) && parameters.cameraForward.w != 0.0) {
        origin = parameters.cameraOrigin.xyz + offset;
        direction = parameters.cameraForward.xyz;
    } else {
        origin = parameters.cameraOrigin.xyz;
        precise vec3 through = parameters.cameraForward.xyz + offset;
        direction = normalize(through);
    }
}

#endif
