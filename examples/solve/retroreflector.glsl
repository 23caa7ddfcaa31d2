// Light that a rough surface sends back to where it came from: a diffuse part, and a lobe about the lamp's direction u.
struct Terms { real u_x, u_y, u_z, v_x, v_y, v_z; };
struct Parameters { real red, green, blue, back, sharpness; };
struct Values { real r, g, b; };

Values value(Parameters p, Terms t) {
    real cosine = max(t.u_x * t.v_x + t.u_y * t.v_y + t.u_z * t.v_z, 1.0e-4);
    real lobe = p.back * exp(p.sharpness * log(cosine));
    return Values((p.red + lobe) * t.u_z, (p.green + lobe) * t.u_z, (p.blue + lobe) * t.u_z);
}
