//! Certificates in 3MF files: what a print check said, as metadata.

use crate::cli::RuleArgs;
use crate::failure::Failure;
use crate::job::Job;
use crate::output::{Report, short};
use crate::slicing;
use mesh::Mesh;
use mesh::io::Attachments;
use printable::check::{Certificate, CertificateError, CheckSettings, PrintCheck};
use printable::{SupportRule, slices::SliceError};
use serde_json::json;
use std::path::Path;

/// The metadata's name.
const NAME: &str = "PrintCertificate";

/// The certificate that a file carries, if it does.
///
/// Errors: a text that is no certificate.
pub fn of_file(attachments: &Attachments) -> Option<Result<Certificate, CertificateError>> {
    let (_, text) = attachments.metadata.iter().find(|(name, _)| name == NAME)?;
    Some(text.parse())
}

/// What to ask of a part: what the user said, else what the certificate says, else what is usual.
pub fn settings(rule: &RuleArgs, certificate: Option<&Certificate>) -> CheckSettings {
    let usual = certificate.map_or_else(CheckSettings::default, Certificate::settings);
    let SupportRule { layer_height, overhang } = usual.rule;
    CheckSettings {
        rule: SupportRule {
            layer_height: rule.layer_height.unwrap_or(layer_height),
            overhang: rule.max_overhang.unwrap_or(overhang),
        },
        bottom: rule.bed.map_or(usual.bottom, Into::into),
        ..usual
    }
}

/// Checks a mesh and puts the certificate into the attachments, or into the report why there is none.
///
/// Errors: a mesh that cannot be sliced or has too many layers; an interruption.
pub fn certify(
    source: &Path,
    mesh: &Mesh,
    rule: &RuleArgs,
    attachments: &mut Attachments,
    report: &mut Report,
    job: &mut Job,
) -> Result<(), Failure> {
    let settings = settings(rule, None);
    let check = slicing::check(mesh, &settings, job)?.map_err(|e| Failure::of(source, e))?;
    let certificate = Certificate::of(&check).map_err(|e| Failure::of(source, e))?;
    report.put("certified", certificate.is_some());
    let SupportRule { layer_height, overhang } = settings.rule;
    let rule =
        format!("layers of {} mm and overhangs of {}°", short(layer_height.mm()), short(overhang.degrees()));
    match certificate {
        Some(certificate) => {
            attachments.metadata.push((NAME.to_owned(), certificate.to_string()));
            report.line(format!("certified       prints without supports with {rule}"));
        }
        None => {
            report.found = true;
            report.line(format!("not certified   needs supports with {rule}"));
            check.findings.iter().find(|f| f.kind.is_serious()).into_iter().for_each(|finding| {
                report.line(format!("problem         {finding}"));
            });
        }
    }
    Ok(())
}

/// Puts a certificate to the test and tells the result. `check` is of the same mesh, `known` if it was made with the
/// certificate's own settings; else another check is made.
///
/// Errors: an interruption.
pub fn verify(
    certificate: &Result<Certificate, CertificateError>,
    mesh: &Mesh,
    known: Option<&PrintCheck>,
    report: &mut Report,
    job: &mut Job,
) -> Result<(), Failure> {
    let doubts = match certificate {
        Err(error) => vec![error.to_string()],
        Ok(certificate) => {
            let settings = certificate.settings();
            let same = known.filter(|check| is_same(&check.settings, &settings));
            let check: Result<_, SliceError> = match same {
                Some(check) => Ok(check.clone()),
                None => slicing::check(mesh, &settings, job)?,
            };
            match check {
                Ok(check) => certificate.doubts(&check).iter().map(ToString::to_string).collect(),
                Err(error) => vec![error.to_string()],
            }
        }
    };
    match doubts.first() {
        None => report.line("certificate     holds"),
        Some(doubt) => report.line(format!("problem         the certificate does not hold: {doubt}")),
    }
    report.found |= !doubts.is_empty();
    report.put("certificate", json!({ "holds": doubts.is_empty(), "doubts": doubts }));
    Ok(())
}

/// Whether two checks ask the same of the layers.
fn is_same(a: &CheckSettings, b: &CheckSettings) -> bool {
    a.rule == b.rule && a.bottom == b.bottom && a.tolerance_mm == b.tolerance_mm
}
