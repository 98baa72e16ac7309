// Faces that coincide where light goes through one of them: a glass that stands exactly on a table, liquid that touches
// its glass, foil on a pane. A ray meets all of them, one after the other and in an order of their own, whatever rounding
// makes of their distances and whichever comes first in the file; a ray back meets them in the reverse order.
//
// Along a ray they stand in this order. Where an opaque face or a thin pane is among them, it keeps solids apart: solids
// end before it and begin behind it, as if there was a gap. Of a pane and an opaque face the pane is on the latter's
// front. Solids with nothing between them touch without a gap: the next one begins before the last one ends, so that
// the two make one interface (media_stack.glsl). Opaque faces are one: the first in the file that stops the ray.
#ifndef COINCIDENT_GLSL
#define COINCIDENT_GLSL

const uint kMostCoincident = 8u;

const uint FACE_OPAQUE = 0u;
const uint FACE_PANE = 1u;
const uint FACE_SOLID = 2u;

struct Face {
    uint triangle;  // its first texel in bvhTriangles
    float t;
    uint primitive;
    uint kind;      // FACE_*
    bool front;     // the ray meets its front
};

struct Faces {
    Face face[kMostCoincident];
    uint count;
};

// Whether the order of coincident faces matters: opaque ones are one, whichever is met.
#define facesHaveOrder()                       \
    ((featureBit(FEATURE_COINCIDENT_FACES) & \
      (featureBit(FEATURE_TRANSMISSION) | featureBit(FEATURE_DIFFUSE_TRANSMISSION))) != 0u)

bool mayCoincide(uint material) { return facesHaveOrder() && (materialFlags(material) & MATERIAL_COINCIDENT) != 0u; }

uint faceKind(uint material) {
    uint flags = materialFlags(material);
    bool transmits = materialTransmission(material) > 0.0 || materialDiffuseTransmission(material) > 0.0;
    if (!transmits || (flags & MATERIAL_UNLIT) != 0u) return FACE_OPAQUE;
    return (flags & MATERIAL_THIN) != 0u ? FACE_PANE : FACE_SOLID;
}

// Of a shape; of fields no face coincides with another.
ShapePoint coincidentPoint(Candidate found, Ray ray) {
    return shapePointAt(LOAD(bvhTriangles, found.texel).x, ray.origin, ray.direction, found.t, false);
}

vec3 triangleNormal(Candidate found) {
    vec3 corner[3];
    loadCorners(Hit(0.0, found.primitive, vec2(0), found.texel), corner);
    vec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
    return cross(a / max(maxComponent(abs(a)), 1e-37), b / max(maxComponent(abs(b)), 1e-37));
}

// Adds the face at a texel if it has the ray's origin in it and lies in the ray's start plane.
void addCoincident(uint texel, Ray ray, ShearRay shear, inout Faces faces) {
    Candidate found = Candidate(ray.tMax, kNoPrimitive, 0u);
    hitPrimitive(texel, ray, shear, false, found);
    if (found.primitive == kNoPrimitive || faces.count == kMostCoincident) return;
    bool coplanar;
    vec3 normal;
    if (has(FEATURE_SHAPES) && (LOAD(bvhTriangles, texel).w & kBvhShape) != 0u) {
        ShapePoint point = coincidentPoint(found, ray);
        coplanar = isCoplanarShape(LOAD(bvhTriangles, texel).x, ray, point);
        normal = point.normal;
    } else {
        coplanar = isCoplanarTriangle(texel, ray);
        normal = triangleNormal(found);
    }
    if (!coplanar) return;
    bool front = dot(normal, ray.direction) <= 0.0;
    uint kind = faceKind(loadPrimitive(found.primitive).material);
    faces.face[faces.count++] = Face(texel, found.t, found.primitive, kind, front);
}

// All faces that coincide with the surface where it is, itself among them, as a ray through that point meets them.
Faces facesAt(Surface s, vec3 direction, uint key, bool culls) {
    Ray ray = freeRay(s.position, direction, 0.0, key);
    startOn(s, ray);
    ray.culls = culls;
    float reach = ray.startReach;
    ray.skipPrimitive = kNoPrimitive;
    ray.startReach = -INFINITY;  // none is passed over
    ray.tMin = -reach;
    ray.tMax = reach;
    // Boxes are entered from a point further back: they are widened by a part of the distance, which has to be positive.
    BoxRay box = makeBoxRay(freeRay(s.position - reach * direction, direction, 0.0, key));
    ShearRay shear = makeShearRay(ray);
    shear.tMin = -reach;
    Faces faces;
    faces.count = 0u;
    uint waiting[kBvhStackSize];
    waiting[0] = kBvhDone;
    uint top = 1u;
    uint current = kBvhRoot;
    while (current != kBvhDone) {
        bool pop = true;
        if ((current & kBvhLeaf) == 0u) {
            bvec4 enters = notEqual(enterChildren(current, box, 0.0, 2.0 * reach), uvec4(kBvhNotEntered));
            uvec4 references = LOAD(bvhNodes, current + 6u);
            for (int slot = 0; slot < 4; ++slot) {
                if (!enters[slot]) continue;
                if (!pop) waiting[top++] = current;
                current = references[slot];
                pop = false;
            }
        } else {
            uint last = current >> kBvhCountShift & 3u;
            for (uint i = 0u; i <= last; ++i)
                addCoincident((current & kBvhAddress) + i * kBvhTriangleTexels, ray, shear, faces);
        }
        if (pop) current = waiting[--top];
    }
    return faces;
}

// What faces stand around: the opaque one, and whether it or a pane keeps solids apart.
struct FaceOrder {
    uint opaque;  // primitive, kNoPrimitive: none
    bool opaqueFront;
    bool apart;
};

void takeIntoOrder(Face face, inout FaceOrder order) {
    if (face.kind != FACE_SOLID) order.apart = true;
    if (face.kind == FACE_OPAQUE && face.primitive < order.opaque) {
        order.opaque = face.primitive;
        order.opaqueFront = face.front;
    }
}

// Where a face stands along the ray: what comes first is less. Of those in one place the second word decides; it changes
// its sign with the ray's direction, as the first does.
ivec2 placeOf(Face face, FaceOrder order) {
    int tie = face.front ? -1 - int(face.primitive) : 1 + int(face.primitive);
    if (face.kind == FACE_SOLID) return ivec2(face.front == order.apart ? 2 : -2, tie);
    if (face.kind == FACE_PANE && order.opaque != kNoPrimitive) return ivec2(order.opaqueFront ? -1 : 1, tie);
    return ivec2(0, face.kind == FACE_OPAQUE ? 0 : tie);
}

bool comesBefore(ivec2 a, ivec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

// The first of the faces behind `after`, which stands for the ray's start; for all of them it stands before any.
bool firstBehind(Faces faces, FaceOrder order, ivec2 after, out Face first) {
    bool found = false;
    ivec2 best = ivec2(0x7fffffff);
    for (uint i = 0u; i < faces.count; ++i) {
        if (faces.face[i].kind == FACE_OPAQUE && faces.face[i].primitive != order.opaque) continue;
        ivec2 place = placeOf(faces.face[i], order);
        if (!comesBefore(after, place) || !comesBefore(place, best)) continue;
        best = place;
        first = faces.face[i];
        found = true;
    }
    return found;
}

Hit hitOn(Face face, Surface s, vec3 direction, float t) {
    Hit hit = Hit(t, face.primitive, vec2(0), face.triangle);
    if (!(has(FEATURE_SHAPES) && isShape(hit)))
        hit.barycentrics = barycentricsOf(makeShearRay(freeRay(s.position, direction, 0.0, 0u)), face.triangle);
    return hit;
}

// Of the faces that coincide where a ray arrives, it meets the first in order, whichever traversal found: makes `hit` and
// the surface those of that.
void arriveAmongFaces(inout Surface s, Ray ray, inout Hit hit) {
    if (!mayCoincide(s.material)) return;
    Faces faces = facesAt(s, ray.direction, ray.key, ray.culls);
    if (faces.count < 2u) return;
    FaceOrder order = FaceOrder(kNoPrimitive, false, false);
    for (uint i = 0u; i < faces.count; ++i) takeIntoOrder(faces.face[i], order);
    Face first;
    if (firstBehind(faces, order, ivec2(-0x7fffffff), first) && first.primitive != hit.primitive) {
        hit = hitOn(first, s, ray.direction, hit.t);
        s = surfaceAt(hit, ray);
    }
    s.coincides = true;
}

// Of the faces that coincide with the one where a ray starts, the next in order along the ray: it is not behind the ray
// but at its start, and traversal passes over it. False: there is none.
bool nextAmongFaces(Surface s, vec3 direction, uint key, out Hit hit) {
    if (!facesHaveOrder() || !s.coincides) return false;
    Faces faces = facesAt(s, direction, key, cullsAll());
    bool front = (dot(s.geometricNormal, direction) < 0.0) == s.frontFace;
    Face start = Face(0u, 0.0, s.primitive, faceKind(s.material), front);
    FaceOrder order = FaceOrder(kNoPrimitive, false, false);
    takeIntoOrder(start, order);
    // One that reflects is the opaque one, whichever else is there.
    for (uint i = 0u; i < faces.count; ++i)
        if (start.kind != FACE_OPAQUE || faces.face[i].kind != FACE_OPAQUE) takeIntoOrder(faces.face[i], order);
    Face next;
    if (!firstBehind(faces, order, placeOf(start, order), next)) return false;
    hit = hitOn(next, s, direction, 0.0);
    return true;
}

#endif
