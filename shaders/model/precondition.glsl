// An entry of the preconditioner P, from that of diag(J'J) / S-bar with the penalties added: not below 1e-4 of the
// problem's largest, plus `least`. The includer says what an element is. C++: model/penalty.h.
SHARED_FN element preconditioner(element entry, element largest, element least) {
    return max(real(1.0e-4) * largest + least, entry);
}
