// An entry of the preconditioner P from that of diag(J'J) / S-bar with the penalties' own: not below 1e-4 of the problem's
// largest, and `least` more than nothing. The includer says what an element is. C++: model/penalty.h.
SHARED_FN element preconditioner(element entry, element largest, element least) {
    return max(real(1.0e-4) * largest + least, entry);
}
