// The first surface along a camera ray, and what every integrator says of it in the film.
#ifndef FIRST_SURFACE_GLSL
#define FIRST_SURFACE_GLSL

bool firstSurface(SampleKey key, vec3 origin, vec3 direction, out Hit hit, out Surface s) {
    Ray ray = viewRay(key, origin, direction, cutoutKey(key, 0u));
    rayCount++;
    if (!closestHit(ray, hit)) return false;
    s = surfaceAt(hit, ray);
    return true;
}

PathSample nothingSeen() { return PathSample(vec3(0), vec3(0), vec3(0), 0.0, 0.0); }

PathSample seenAs(vec3 radiance, Surface s, MaterialPoint m, float t) {
    noteFirstSurface(s);
    return PathSample(radiance, m.baseColor, s.frame[2], t, 1.0);
}

#endif
